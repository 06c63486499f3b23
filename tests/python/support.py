# SPDX-License-Identifier: Apache-2.0
"""Data and devices of the tests, and their exit code."""

import os
import pathlib
import resource
import sys
import unittest

import numpy as np
from PIL import Image

import ibr

DATA = pathlib.Path(os.environ["IBR_PYTHON_DATA"])
SOURCE = pathlib.Path(os.environ["IBR_SOURCE"])
COURT = DATA / "court"  # images, sparse and truth of a synthetic court: ibr-lab synth court
FIGURE = DATA / "figure" / "frame0000"  # mesh, images, masks and sparse of a figure: ibr-lab synth moving
SCENE = DATA / "scene"  # built from COURT by make_data.py
MODEL = DATA / "model"  # built from FIGURE by make_data.py


def device():
    """Returns a device with validation. Skips the case where there is none, or fails it with IBR_REQUIRE_DEVICE."""
    if ibr.preferred_device() is None:
        if os.environ.get("IBR_REQUIRE_DEVICE"):
            raise AssertionError("no Vulkan device")
        raise unittest.SkipTest("no Vulkan device")
    return ibr.Device(validation=True)


def picture_of(file):
    """Returns the pixels of an image file."""
    with Image.open(file) as image:
        return np.asarray(image)


class DeviceTest(unittest.TestCase):
    """Cases share a device, whose validation layer must report nothing."""

    @classmethod
    def setUpClass(cls):
        cls.device = device()

    @classmethod
    def tearDownClass(cls):
        messages = cls.device.validation_messages
        del cls.device
        if messages:
            raise AssertionError(f"{messages} validation messages")


def code_of(call):
    """Returns the code of the ibr.Error that the call raises."""
    try:
        call()
    except ibr.Error as error:
        return error.code
    raise AssertionError("no ibr.Error was raised")


def started_children():
    """True if this process has waited for a child process."""
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss > 0


def main():
    """Runs the cases of the program. Exit code 77: all were skipped."""
    result = unittest.main(exit=False, verbosity=2).result
    if not result.wasSuccessful():
        sys.exit(1)
    skipped_cases = [case for case, _ in result.skipped if isinstance(case, unittest.TestCase)]
    sys.exit(77 if result.skipped and result.testsRun == len(skipped_cases) else 0)
