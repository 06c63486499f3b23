# SPDX-License-Identifier: Apache-2.0
# Enumerations.
import enum

class ErrorCode(enum.Enum):
    INVALID_INPUT = 0
    IO = 1
    UNSUPPORTED = 2
    OUT_OF_MEMORY = 3
    DEVICE_LOST = 4
    VULKAN = 5
    CANCELLED = 6

class DeviceKind(enum.Enum):
    SOFTWARE = 0
    HARDWARE = 1

class AssetKind(enum.Enum):
    SCENE = 0
    HTM_MODEL = 1
    HTM_SEQUENCE = 2

class CameraModel(enum.Enum):
    PINHOLE = 0
    EQUIRECTANGULAR = 1

class Composition(enum.Enum):
    CELLS = 0
    GATHERED = 1
    HYBRID = 2

class BlendMode(enum.Enum):
    BLEND = 0
    DITHER = 1
    MIXED = 2

class Morph(enum.Enum):
    OURS = 0
    PAPER = 1

class DrawOrder(enum.Enum):
    OURS = 0
    PAPER = 1

class ColourMapping(enum.Enum):
    OFF = 0
    OURS = 1
    PAPER = 2
    PAPER_REDRAW = 3

class Exposure(enum.Enum):
    OFF = 0
    SCENE = 1
    ADAPTED = 2

class ColourTable(enum.Enum):
    NAIVE = 0
    STRICT = 1
    PRESERVING = 2

class AlphaContent(enum.Enum):
    OPAQUE = 0
    TIER = 1

class Overlay(enum.Enum):
    NONE = 0
    WIREFRAME = 1
    TIERS = 2
    WEIGHTS = 3
    CONFIDENCE = 4
    DEPTH = 5
    OVERLAP = 6
    AGREEMENT = 7

class Preset(enum.Enum):
    FAST = 0
    BALANCED = 1
    ACCURATE = 2
    REFERENCE = 3

class TextureFilter(enum.Enum):
    AUTOMATIC = 0
    BILINEAR = 1
    TRILINEAR = 2
    BICUBIC = 3

class BlockTextureMode(enum.Enum):
    AUTOMATIC = 0
    KEEP = 1
    DECODE = 2

class TextureFormat(enum.Enum):
    RGBA8 = 0
    BC1 = 1
    BC7 = 2

class HtmMethod(enum.Enum):
    HARMONISED = 0
    BLENDED = 1
    VERTEX_COLOURS = 2

class HtmDirection(enum.Enum):
    MIDDLE = 0
    AXIS = 1

class AlignmentMethod(enum.Enum):
    RASTER = 0
    COMPUTE = 1
    CPU = 2
    GRADIENT = 3

class EccDefinition(enum.Enum):
    CHANNELS = 0
    CONCATENATED = 1

class AdviceKind(enum.Enum):
    TOO_FEW = 0
    TURNED = 1
    APART = 2
    HOLE = 3
    WIDE = 4
    DIRECTION = 5
    EXPOSURE = 6
    BLURRED = 7
    UNMATCHED = 8
    POSE = 9
    UNUSED = 10
    TWICE = 11
    ROW = 12

class Severity(enum.Enum):
    HINT = 0
    WARNING = 1
    SERIOUS = 2
