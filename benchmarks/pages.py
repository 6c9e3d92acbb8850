"""Tables in pages of the documentation, between two marks each."""


def put_table(path, name, lines):
    """Replace what stands between the marks of a table on a page."""
    first, last = f"<!-- {name} begins -->\n", f"<!-- {name} ends -->"
    before, found, rest = path.read_text().partition(first)
    if not found:
        raise ValueError(f"{path}: no mark {first.strip()}")
    path.write_text(before + first + "\n".join(lines) + "\n" + last + rest.partition(last)[2])
