"""Ctrl-C, also where it met compiled code."""

INTERRUPTED = 130  # as a shell tells SIGINT


def was_interrupted(error: BaseException) -> bool:
    """Whether `error` is Ctrl-C: compiled code turns a KeyboardInterrupt into a SystemError that has it as its cause."""
    seen: BaseException | None = error
    while seen is not None and not isinstance(seen, KeyboardInterrupt):
        seen = (seen.__cause__ or seen.__context__) if isinstance(seen, SystemError) else None
    return seen is not None
