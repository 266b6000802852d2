"""An XML document as bytes."""

from xml.etree.ElementTree import Element, indent, tostring


def xml_file(root: Element) -> bytes:
    """Return the document, an element a line, with a declaration and a line feed at the end."""
    indent(root)
    text: bytes = tostring(root, encoding="utf-8", xml_declaration=True)
    return text + b"\n"
