"""LZF, the compression of PCD files (`binary_compressed`)."""

from floorplan.compiled import compiled
from floorplan.model.checks import Array


@compiled
def unpack_lzf(packed: Array, out: Array) -> int:
    """Unpack LZF data (Lehmann's format) into `out`; gives back how many bytes came out, -1 where the data are damaged."""
    at, end = 0, 0
    while at < len(packed):
        control = int(packed[at])
        at += 1
        if control < 32:
            run = control + 1
            if at + run > len(packed) or end + run > len(out):
                return -1
            for _ in range(run):
                out[end] = packed[at]
                at, end = at + 1, end + 1
            continue
        run = control >> 5
        if run == 7 and at < len(packed):
            run += int(packed[at])
            at += 1
        if at >= len(packed):
            return -1
        back = end - ((control & 31) << 8) - int(packed[at]) - 1
        at += 1
        if back < 0 or end + run + 2 > len(out):
            return -1
        for _ in range(run + 2):
            out[end] = out[back]
            end, back = end + 1, back + 1
    return end
