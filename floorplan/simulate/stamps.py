"""Stamps as text."""


def seconds_text(stamp_ns: int) -> str:
    """Seconds with nine decimals, exact."""
    return f"{stamp_ns // 10**9}.{stamp_ns % 10**9:09d}"
