"""A record of a pack and its files for an archive: RO-Crate 1.1, ro-crate-metadata.json beside the pack (packmpi report PACK --crate LICENCE)."""
import datetime
import hashlib
import json
from pathlib import Path
from typing import Any

from .pack import Pack
from .problem import Problem

FILE = "ro-crate-metadata.json"
KINDS = {".hdf": "application/x-hdf5", ".json": "application/json", ".csv": "text/csv", ".log": "text/plain", ".html": "text/html",
         ".png": "image/png", ".svg": "image/svg+xml", ".toml": "application/toml", ".ipynb": "application/x-ipynb+json"}


def licence_address(words: str) -> str:
    """An address as it is; else a name of SPDX's list."""
    return words if "://" in words else f"https://spdx.org/licenses/{words}"


def file_entry(path: Path) -> dict[str, Any]:
    """Of one file, with its size and digest."""
    with path.open("rb") as file:
        digest = hashlib.file_digest(file, "sha256").hexdigest()
    return {"@id": path.name, "@type": "File", "name": path.name, "contentSize": str(path.stat().st_size), "sha256": digest,
            "encodingFormat": KINDS.get(path.suffix, "application/octet-stream")}


def measured(pack: Pack) -> list[dict[str, Any]]:
    """What the pack has come to."""
    values = {"particles": (pack.count, ""), "solid fraction of the bulk": (pack.phi_bulk, ""), "porosity of the bulk": (pack.porosity_bulk, ""),
              "void ratio of the bulk": (pack.void_ratio_bulk, ""), "coordination number": (pack.summary["coordination"], ""),
              "height": (pack.summary["height"], "m")}
    return [{"@id": f"#{name.replace(' ', '-')}", "@type": "PropertyValue", "name": name, "value": value, **({"unitText": unit} if unit else {})}
            for name, (value, unit) in values.items()]


def record(pack: Pack, licence: str, date: str) -> dict[str, Any]:
    """The record of a pack that has a file, and of all files beside it that have its name."""
    path, made = pack.path, pack.provenance
    if path is None:
        raise Problem("this pack is in memory only: save() it first")
    files = sorted(one for one in path.parent.iterdir() if one.is_file() and not one.is_symlink() and one.name.startswith(f"{pack.name}."))
    values = measured(pack)
    root = {"@id": "./", "@type": "Dataset", "name": f"{pack.name}: a pack of {pack.count} {pack.noun}",
            "description": f"Dense random pack of {pack.count} {pack.noun}, seed {made['seed']}, made by packmpi {made['version']} ({made['git']}). The scene "
                           "with every default is /provenance/effective_input of the pack; with it, the same version makes the same bits.",
            "datePublished": date, "license": {"@id": licence_address(licence)}, "hasPart": [{"@id": one.name} for one in files],
            "variableMeasured": [{"@id": one["@id"]} for one in values], "mentions": {"@id": "#run"}}
    run = {"@id": "#run", "@type": "CreateAction", "name": f"packmpi {made['scene_file']} --seed {made['seed']}", "instrument": {"@id": "#packmpi"},
           "result": [{"@id": path.name}]}
    program = {"@id": "#packmpi", "@type": "SoftwareApplication", "name": "packmpi", "version": made["version"],
               "softwareVersion": f"{made['version']} ({made['git']}), {made['compiler']}, {made['architecture']}"}
    about = {"@id": FILE, "@type": "CreativeWork", "about": {"@id": "./"}, "conformsTo": {"@id": "https://w3id.org/ro/crate/1.1"}}
    terms = {"@id": licence_address(licence), "@type": "CreativeWork", "name": licence}
    return {"@context": "https://w3id.org/ro/crate/1.1/context", "@graph": [about, root, *map(file_entry, files), run, program, terms, *values]}


def write_record(pack: Pack, licence: str) -> Path:
    """Writes it beside the pack; another pack's record is not replaced. Raises Problem."""
    if pack.path is None:
        raise Problem("this pack is in memory only: save() it first")
    target = pack.path.parent / FILE
    words = json.dumps(record(pack, licence, datetime.date.today().isoformat()), indent=2, ensure_ascii=False)
    try:
        if target.exists() and {"@id": pack.path.name} not in json.loads(target.read_text(encoding="utf-8"))["@graph"][1]["hasPart"]:
            raise Problem(f"{target} is the record of other files; give each pack a folder of its own")
        target.write_text(words + "\n", encoding="utf-8")
    except (OSError, ValueError, LookupError, TypeError) as error:
        raise Problem(f"cannot write {target}: {error}") from error
    return target
