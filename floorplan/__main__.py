"""`python -m floorplan`: the command line where the `floorplan` command is not on the path."""

from floorplan.cli import main

main()
