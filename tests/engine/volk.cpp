// SPDX-License-Identifier: Apache-2.0
// Defines volk's pointers, vkCmdDraw and so on.
#define VOLK_IMPLEMENTATION
#include <volk.h>
