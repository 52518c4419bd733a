"""validate.py SCHEMA_FOLDER FOLDER: prints the names of those FOLDER/<kind>.<name>.json that their schema accepts."""
import json
import pathlib
import sys

import jsonschema

schemas, folder = map(pathlib.Path, sys.argv[1:])
for file in sorted(folder.glob("*.*.json")):
    schema = json.loads((schemas / f"{file.name.split('.')[0]}.schema.json").read_text())
    if jsonschema.Draft202012Validator(schema).is_valid(json.loads(file.read_text())):
        print(file.name)
