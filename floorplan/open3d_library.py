"""The one module that imports Open3D."""

import ctypes
from typing import Any


def load_open3d() -> Any:
    """Open3D; its missing libusb comes from the package `libusb-package`, loaded first for all to see."""
    import libusb_package

    path = libusb_package.get_library_path()
    if path is not None:
        ctypes.CDLL(str(path), mode=ctypes.RTLD_GLOBAL)
    import open3d

    return open3d
