"""XML as a file, for all that is written as XML."""

from xml.etree.ElementTree import Element, indent, tostring

from ...errors import check_text


def text_of(root: Element) -> bytes:
    """An element as a file, the same bytes for the same element.

    Raises LoomfmuError for a text with a character that XML cannot hold: no parser could read the file.
    """
    for element in root.iter():
        tag = element.tag.rpartition(":")[2]
        for key, value in (*element.attrib.items(), ("text", element.text or "")):
            check_text(value, f"{tag} {key}", len(value))
    indent(root)
    text: str = tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'.encode()
