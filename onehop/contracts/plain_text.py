"""Text that others have said, made fit for one line on a terminal."""


def plain(text: str) -> str:
    """The text with what does not print escaped: line ends, controls, lone surrogates."""
    return "".join(each if each.isprintable() else ascii(each)[1:-1] for each in text)
