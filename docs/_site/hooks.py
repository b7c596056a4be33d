"""MkDocs hooks: the pages and files of the site that do not lie in docs/, and links between the two.

The pages in docs/ can also be read in the repository, where they link to `../README.md` or `../assets/...`. In the
site, README, CONTRIBUTING and CHANGELOG are pages, and every other linked file is copied into `repository/`. The API
reference is generated from the docstrings.
"""

import re
from pathlib import Path, PurePosixPath
from posixpath import normpath, relpath

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).parents[2]
SOURCES = ROOT / "ros2_ws" / "src"
SHIM = "assets/iframe-worker.js"  # lets the search run from file:// addresses

# Page of the site: file of the repository.
PAGES = {"index.md": "README.md", "contributing.md": "CONTRIBUTING.md", "changelog.md": "CHANGELOG.md"}

# Page of the reference: its title, and the modules or objects that it documents.
API = {
    "reference/world.md": ("World", ["drone_engine.world.World"]),
    "reference/fleet.md": ("Fleet", ["drone_engine.fleet"]),
    "reference/scene.md": ("Scene", ["drone_engine.scene"]),
    "reference/collision.md": ("Collision queries", [
        "drone_engine.collision.queries", "drone_engine.collision.mesh.shape"]),
    "reference/renderer.md": ("Renderer", ["drone_render.renderer", "drone_render.passes", "drone_render.frame.frame",
                                           "drone_render.film"]),
    "reference/effects.md": ("Effects", ["drone_engine.effects"]),
    "reference/flight.md": ("Flight", ["drone_engine.flight"]),
    "reference/extensions.md": ("Extensions", [
        "drone_engine.behavior", "drone_engine.context", "drone_engine.extension"]),
}
# Packages whose modules are listed in full, kernels included.
INTERNALS = ["collision", "dynamics", "geometry", "math", "program"]

_FOLDER_LINK = re.compile(r"\[([^\]]*)\]\(([^)\s]+/)\)")
_LINK = re.compile(r"""(\]\(|(?:src|href)=")([^)\s"#]+)""")


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Adds the pages and files from outside docs/ to the site."""
    for page, source in PAGES.items():
        files.append(File.generated(config, page, abs_src_path=str(ROOT / source)))
    files.append(File.generated(config, SHIM, abs_src_path=str(Path(__file__).with_name("iframe-worker.js"))))
    for page, text in _reference():
        files.append(File.generated(config, page, content=text))
    for page in list(files.documentation_pages()):
        for link in _links(page.content_string):
            inside, target = _resolve(page.src_uri, link)
            if not inside and target and not files.get_file_from_path(target):
                source = ROOT / target.removeprefix("repository/")
                if source.is_file():
                    files.append(File.generated(config, target, abs_src_path=str(source)))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Points links that leave docs/ to the copies in the site. Links to folders become plain text."""
    def replace(match: re.Match[str]) -> str:
        inside, target = _resolve(page.file.src_uri, match[2])
        if inside or not target or not files.get_file_from_path(target):
            return match[0]
        return match[1] + relpath(target, PurePosixPath(page.file.src_uri).parent)

    def text_of_folder(match: re.Match[str]) -> str:
        inside, target = _resolve(page.file.src_uri, match[2])
        return match[0] if inside or not target else match[1]

    return _LINK.sub(replace, _FOLDER_LINK.sub(text_of_folder, markdown))


def _links(markdown: str) -> list[str]:
    return [match[2] for match in _LINK.finditer(markdown)]


def _resolve(page: str, link: str) -> tuple[bool, str]:
    """(whether MkDocs resolves the link by itself, path in the site or "" for an address)."""
    if "://" in link or link.startswith("mailto:"):
        return True, ""
    folder = PurePosixPath(PAGES[page]).parent if page in PAGES else PurePosixPath("docs") / PurePosixPath(page).parent
    path = normpath(str(folder / link))  # from the root of the repository
    for target, source in PAGES.items():
        if path == source:
            return False, target
    if path.startswith("docs/"):
        return page not in PAGES, path.removeprefix("docs/")
    return False, f"repository/{path}"


def _reference() -> list[tuple[str, str]]:
    """(page, Markdown) of each page of the API reference."""
    pages = [(page, _page(title, names)) for page, (title, names) in API.items()]
    for package in INTERNALS:
        if (SOURCES / "drone_engine" / "drone_engine" / package).is_dir():
            name = f"drone_engine.{package}"
            pages.append((f"reference/internals/{package}.md", _page(name, [name])))
    return pages


def _page(title: str, names: list[str]) -> str:
    lines = [f"# {title}", ""]
    for name in names:
        for module in _modules(name):
            lines += [f"::: {module}", ""]
    return "\n".join(lines)


def _modules(name: str) -> list[str]:
    """The module or object itself, and the modules of a package, in depth-first order."""
    path = SOURCES / name.split(".")[0] / Path(*name.split("."))
    if not path.is_dir():
        return [name]
    names = [name]
    for child in sorted(path.iterdir()):
        if child.is_dir() and (child / "__init__.py").exists():
            names += _modules(f"{name}.{child.name}")
        elif child.suffix == ".py" and not child.name.startswith("__"):
            names.append(f"{name}.{child.stem}")
    return names
