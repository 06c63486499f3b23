# SPDX-License-Identifier: Apache-2.0
# Types of ibr._runtime, by topic. There is no such module at run time.
