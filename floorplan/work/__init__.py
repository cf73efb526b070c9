"""The work folder: stages, keys, chunks, lock. It knows how a value is kept, never how it is made.

stage        one step of the job whose result is kept in its own folder (`1-ingest` .. `6-plan`)
recipe       what a result was made with: stage, version, config sections, keys of its inputs, the scan's fingerprint
key          the hash of a recipe; a folder whose key matches is kept
chunk        a part of the slow stage, kept in `2-segments.partial` until the stage is whole
"""
