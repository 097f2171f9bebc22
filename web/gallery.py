"""The scenarios of pictures with a command below, for live pictures of the site and examples of the page to try, and links to that page."""
import pathlib
import re
import shlex
import tomllib
import urllib.parse
import zlib

REPOSITORY = pathlib.Path(__file__).resolve().parent.parent
# A picture above its command.
PICTURE = re.compile(r"(!\[[^\]]*\]\([^)]*\))\n\n`(archrock [^`]*)`")


def scenario_of(command):
    """Returns the scenario of a command with its --set options as text; None if there is none, or it names a file."""
    words = shlex.split(command)
    path = next((REPOSITORY / word for word in words if word.endswith(".toml")), None)
    if path is None:
        return None
    text = path.read_text(encoding="utf-8")
    for setting in (after for word, after in zip(words, words[1:]) if word == "--set"):
        key, value = setting.split("=", 1)
        table, key = key.rsplit(".", 1)
        before, head, body = text.partition(f"[{table}]\n")
        body, more, rest = body.partition("\n[")
        body = re.sub(rf"^{key} *=.*\n?", "", body, flags=re.M)
        text = f"{before.rstrip()}\n\n[{table}]\n{key} = {value}\n{body.rstrip()}\n{more}{rest}"

    def names_file(value):
        values = value.values() if isinstance(value, dict) else value if isinstance(value, list) else []
        return isinstance(value, str) and value and any(path.parent.glob(value)) or any(map(names_file, values))
    return None if names_file(tomllib.loads(text)) else text


def link(scenario):
    """Returns the end of an address that opens the page to try with a scenario, as its address.js makes it."""
    return f"#check={zlib.crc32(scenario.encode()):08x}&scenario={urllib.parse.quote(scenario, safe='')}"


def examples():
    """Returns the examples of the pictures in docs/recipes.md, each once: title, scenario, and study."""
    found = {}
    for _, command in PICTURE.findall((REPOSITORY / "docs/recipes.md").read_text(encoding="utf-8")):
        scenario = scenario_of(command)
        if scenario:
            example = {"title": tomllib.loads(scenario)["title"], "scenario": scenario, "study": command.split()[1]}
            found.setdefault((example["title"], example["study"]), example)
    return list(found.values())
