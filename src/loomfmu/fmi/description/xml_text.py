"""XML as a file, for all that is written as XML."""

from xml.etree.ElementTree import Element, indent, tostring


def text_of(root: Element) -> bytes:
    """An element as a file, the same bytes for the same element."""
    indent(root)
    text: str = tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'.encode()
