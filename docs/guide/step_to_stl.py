# SPDX-License-Identifier: Apache-2.0
"""Writes one STL file in mm for each body of a STEP file, named as the body is in CAD. It runs in
FreeCAD without a window (Debian: freecad-python3), which takes no options for a script:

    STEP=machine.step OUT=meshes freecadcmd docs/guide/step_to_stl.py </dev/null

Facets are at most DEVIATION_MM [default: 0.05] from the surface: add that to margin_mm. Hidden
parts are left out. Tried with FreeCAD 0.20.2."""
import os
import pathlib
import re
import sys

import FreeCAD
import Import
import MeshPart


def main():
    step, out = os.environ["STEP"], pathlib.Path(os.environ["OUT"])
    deviation_mm = float(os.environ.get("DEVIATION_MM", "0.05"))
    out.mkdir(parents=True, exist_ok=True)
    document = FreeCAD.newDocument("step")
    Import.insert(step, document.Name, False, False)  # no hidden parts; compounds stay apart
    taken = []
    for part in document.Objects:
        if not part.isDerivedFrom("Part::Feature") or not part.Shape.Solids:
            continue
        shape = part.Shape.copy()
        shape.Placement = part.getGlobalPlacement()
        stem = re.sub(r"[^A-Za-z0-9_-]", "_", part.Label) or "body"
        name = stem if stem not in taken else f"{stem}_{len(taken)}"
        taken.append(name)
        mesh = MeshPart.meshFromShape(Shape=shape, LinearDeflection=deviation_mm,
                                      AngularDeflection=0.2)
        mesh.write(str(out / f"{name}.stl"))
        print(f"{name}.stl: {mesh.CountFacets} facets")
    if not taken:
        sys.exit(f"{step}: no solid in it")


main()
