"""Runs the study @NAME@ on Dask in @PARTS@ parts, @EACH@ each, and puts them together:

    python @SCRIPT@ [ADDRESS OF THE SCHEDULER]

Without an address it starts workers on this machine. Called again, it goes on with what is there. The Python package
tautrope must be installed here and where the workers are, of the same version, and all must see the study's files.
"""

import sys

import tautrope
import tautrope.dask
from dask.distributed import Client

if __name__ == "__main__":
    with Client(*sys.argv[1:2]) as client:
        print(tautrope.dask.run(tautrope.Study(@FILE@), client, @OUT@, parts=@PARTS@))
