"""The modules of the package import each other in one direction."""

import ast
import graphlib
from pathlib import Path
from typing import Iterator

PACKAGE = Path(__file__).parents[1] / "package" / "archrock"


def _imported(node: ast.AST) -> Iterator[str]:
    """Modules of the package that code imports, also in functions; types of annotations are imported for the checker alone."""
    if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
        return
    if isinstance(node, ast.ImportFrom) and node.level == 1:
        yield from [node.module] if node.module else [name.name for name in node.names]
    for child in ast.iter_child_nodes(node):
        yield from _imported(child)


def test_no_modules_import_each_other() -> None:
    graph = {file.stem: set(_imported(ast.parse(file.read_text()))) for file in PACKAGE.glob("*.py")}
    assert len(graph) > 5 and "_history" in graph["_scenario"]
    graphlib.TopologicalSorter(graph).prepare()
