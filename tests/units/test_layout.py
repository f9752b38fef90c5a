"""The house's rules: which room may use which, no circle of imports, where kernels are, how long a file may be."""

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]

# Rooms in the order in which data flows: each may import those before it. "pylmc" is the package's own __init__.
ORDER = (
    *(
        "errors",
        "checks",
        "colour",
        "caches",
        "pylmc",
        "options",
        "interruption",
        "progress",
        "settings",
        "moves",
        "lobes",
        "scene",
    ),
    *("geometry", "constraints", "device", "picture", "sampling", "integrators", "inspection", "rendering", "cli", "__main__"),
)
# Rooms that may import these alone.
ONLY = {
    "lobes": {"errors"},
    "scene": {"errors", "checks", "colour", "lobes"},
    "geometry": {"errors"},  # it sees arrays
    "picture": {"errors", "colour"},  # so does it
}
BACKWARDS = {("settings", "integrators"): "the list of integrators, which loads none of them"}

LONGEST = 400  # lines
LONGER: dict[str, str] = {}  # file: why it is one all the same


@cache
def modules() -> dict[str, Path]:
    """The package's modules by name."""
    found = {}
    for path in sorted((ROOT / "pylmc").rglob("*.py")):
        parts = path.relative_to(ROOT).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def only_for_types(tree: ast.AST) -> set[int]:
    """The nodes below ``if TYPE_CHECKING``, which never run."""
    tests = (node for node in ast.walk(tree) if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING")
    return {id(below) for test in tests for below in ast.walk(test)}


def imports(name: str, types: bool) -> Iterator[str]:
    """What a module of the package imports of it, anywhere; with ``types`` also what it imports for type checkers only."""
    path = modules()[name]
    tree = ast.parse(path.read_text(encoding="utf-8"))
    skipped = set() if types else only_for_types(tree)
    for node in ast.walk(tree):
        if id(node) in skipped:
            continue
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name.split(".")[0] == "pylmc")
        elif isinstance(node, ast.ImportFrom):
            package = name.split(".") if path.name == "__init__.py" else name.split(".")[:-1]
            above = package[: len(package) - node.level + 1] if node.level else []
            source = ".".join([*above, *([node.module] if node.module else [])])
            for alias in node.names:
                if source.split(".")[0] == "pylmc":
                    inner = f"{source}.{alias.name}"
                    yield inner if inner in modules() else source


def room(module: str) -> str:
    """The package or file right below pylmc that a module is in."""
    return module.split(".")[1] if "." in module else module


def complaint(user: str, used: str) -> str:
    """What is wrong with the room ``user`` importing from ``used``; empty where nothing is."""
    if user == used or (user, used) in BACKWARDS:
        return ""
    if ORDER.index(used) > ORDER.index(user):
        return f"{used} comes after {user}: data flows one way"
    if user in ONLY and used not in ONLY[user]:
        return f"{user} imports {', '.join(sorted(ONLY[user]))} alone, not {used}"
    return ""


def test_every_room_has_its_place() -> None:
    assert {room(name) for name in modules()} == set(ORDER)


@pytest.mark.parametrize("name", modules())
def test_rooms_import_those_before_them(name: str) -> None:
    used = [module for module in imports(name, types=name != "pylmc") if module != name]  # pylmc offers what it names
    said = {f"{name} imports {module}: {said}" for module in used if (said := complaint(room(name), room(module)))}
    assert not said, "\n".join(sorted(said))


def test_the_rules_see_what_they_are_to_see() -> None:
    assert "one way" in complaint("scene", "geometry") and "one way" in complaint("device", "sampling")
    assert "alone" in complaint("geometry", "scene") and "alone" in complaint("geometry", "lobes")
    assert not complaint("cli", "device")
    found = set(imports("pylmc.cli.commands", types=False))
    assert "pylmc.device.survey" in found, "imports inside of functions count"
    assert "pylmc.sampling.sampler" in set(imports("pylmc", types=True)) - set(imports("pylmc", types=False))


def test_no_circle_of_imports() -> None:
    """Not even one that imports inside of functions would hide."""
    uses = {name: sorted(set(imports(name, types=False)) & modules().keys() - {name}) for name in modules()}
    done: set[str] = set()

    def visit(name: str, above: tuple[str, ...]) -> None:
        assert name not in above, f"a circle: {' -> '.join([*above[above.index(name) :], name])}"
        if name not in done:
            for used in uses[name]:
                visit(used, (*above, name))
            done.add(name)

    for name in uses:
        visit(name, ())


KERNELS = sorted((ROOT / "cl_kernels").rglob("*.cl"))


@pytest.mark.parametrize("path", KERNELS, ids=lambda path: str(path.relative_to(ROOT / "cl_kernels")))
def test_kernel_files(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert re.match(r"// \S.{15,}\n|/\* \S.{15,}", text), "a first comment names the file's concept"
    if path.parent.name != "entry":
        assert "__kernel" not in re.sub(r"//.*|/\*.*?\*/", "", text), "kernels are in entry/"


def test_files_are_short() -> None:
    folders = ("pylmc", "cl_kernels", "tests", "bench", "tools")
    paths = [path for folder in folders for ending in ("py", "cl") for path in (ROOT / folder).rglob(f"*.{ending}")]
    lines = {str(path.relative_to(ROOT)): path.read_text(encoding="utf-8").count("\n") for path in paths}
    long = {name: count for name, count in lines.items() if count > LONGEST}
    assert long.keys() == LONGER.keys(), f"split them, or say here why they are long: {long}"
