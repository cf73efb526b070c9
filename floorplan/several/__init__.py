"""Several scans of one floor: each is built on its own, laid on the first one, and all are solved together.

survey      what one finished scan shows of the building, in its own plan frame: wall faces and free space
laying      a quarter turn and a shift that take one scan's plan frame to another's
start       where to look for it: anywhere, near a common start, or near point pairs measured in both plans
"""
