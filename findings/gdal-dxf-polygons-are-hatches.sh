#!/usr/bin/env bash
# GDAL 3.11.4 (in pyogrio 0.12.1) writes polygons to DXF as fills alone: no polyline, and none of the rings said to be the outer one.
#
# expected: a polygon with a hole becomes two closed polylines (LWPOLYLINE), one a ring, as its lines become polylines; or, if
#           it is filled, a HATCH whose outer ring has the boundary flag "external" (1), with each corner once.
# seen:     one HATCH with a solid fill and nothing else. Both rings have the boundary flag 2 (polyline) alone, so outer ring
#           and hole are told apart by nothing but parity; and each ring, which is closed anyway, repeats its first corner.
# so:       who looks for outlines among polylines, as readers of plans do, finds an empty drawing and no error; and who keeps the
#           rings flagged external keeps none.
# Exits with 0 as long as that is so, else with 1.
set -euo pipefail

folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv room
room/bin/pip install --quiet pyogrio==0.12.1 shapely==2.1.2 ezdxf==1.4.3
cat >polygons.py <<'PYTHON'
import sys
import warnings

import ezdxf
import numpy
import pyogrio
import shapely

warnings.simplefilter("ignore")
outer = [(0, 0), (10, 0), (10, 8), (0, 8)]
hole = [(2, 2), (4, 2), (4, 4), (2, 4)]
polygon = numpy.array([shapely.to_wkb(shapely.Polygon(outer, [hole]))], dtype=object)
pyogrio.raw.write("p.dxf", geometry=polygon, field_data=[], fields=[], geometry_type="Polygon", driver="DXF", crs=None)

space = list(ezdxf.readfile("p.dxf").modelspace())
print("GDAL", pyogrio.__gdal_version__, "wrote", [entity.dxftype() for entity in space])
[hatch] = space
rings = [(path.path_type_flags, [vertex[:2] for vertex in path.vertices]) for path in hatch.paths]
for flags, ring in rings:
    print("boundary flags", flags, "corners", ring)
as_before = hatch.dxftype() == "HATCH" and hatch.dxf.solid_fill == 1
as_before &= [flags for flags, _ in rings] == [2, 2]
as_before &= [ring for _, ring in rings] == [outer + outer[:1], hole + hole[:1]]
sys.exit(0 if as_before else 1)
PYTHON
room/bin/python polygons.py
