"""One macOS library of several, each for its own processor."""

import struct

MAGIC = 0xCAFEBABE
ALIGNMENT = 14  # both kinds of page: 16 kB, as a power of two
THIN_MAGIC = 0xFEEDFACF


def fat_binary(parts: list[bytes]) -> bytes:
    """Mach-O libraries joined under a fat header (mach-o/fat.h): the loader takes the one that fits.

    Raises ValueError for a part that is not a 64-bit Mach-O file.
    """
    header = struct.pack(">2I", MAGIC, len(parts))
    offset = _aligned(len(header) + 20 * len(parts))
    body = b""
    for part in parts:
        magic, processor, kind = struct.unpack_from("<3I", part)
        if magic != THIN_MAGIC:
            raise ValueError(f"a part of a fat binary begins with {magic:#x}, not {THIN_MAGIC:#x}")
        header += struct.pack(">5I", processor, kind, offset + len(body), len(part), ALIGNMENT)
        body += part.ljust(_aligned(len(part)), b"\0")
    return header.ljust(offset, b"\0") + body


def _aligned(size: int) -> int:
    page = 1 << ALIGNMENT
    return -(-size // page) * page
