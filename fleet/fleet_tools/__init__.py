"""What fleet/Snakefile is made of. Needs Python's standard library; the pages also matplotlib."""
import pathlib
import sys

FLEET = pathlib.Path(__file__).resolve().parent.parent
PACKAGE = FLEET.parent
SCRIPTS = PACKAGE / "scripts"
if str(SCRIPTS) not in sys.path:
    sys.path.append(str(SCRIPTS))  # offline_tools, run_report
