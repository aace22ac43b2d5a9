"""Fetches an archive that is not there yet, checks it, and takes some files from it.

fetch.py ADDRESS SHA256 ARCHIVE FOLDER FILE...    FILE without the folder that all of the archive is in
"""

import hashlib
import os
import sys
import tarfile
import urllib.request


def download(address, archive):
    """To a name of its own first: what has the archive's name is complete."""
    part = archive + ".part"
    with urllib.request.urlopen(address, timeout=60) as source, open(part, "wb") as to:
        size = int(source.headers.get("Content-Length", 0))
        done = 0
        while block := source.read(1 << 20):
            to.write(block)
            done += len(block)
            if sys.stderr.isatty():
                print(f"\r{done >> 20} of {size >> 20} MiB ", end="\n" if done == size else "", file=sys.stderr, flush=True)
    os.replace(part, archive)


def check(archive, sha256):
    with open(archive, "rb") as source:
        have = hashlib.sha256(source.read()).hexdigest()
    if have != sha256:
        sys.exit(f"{archive} has the SHA-256 {have}, not {sha256}: delete it and try again")


def unpack(archive, folder, wanted):
    with tarfile.open(archive) as source:
        for member in source:
            name = member.name.partition("/")[2]
            if name in wanted:
                path = os.path.join(folder, name)
                os.makedirs(os.path.dirname(path), exist_ok=True)
                with open(path, "wb") as to:
                    to.write(source.extractfile(member).read())


def main():
    address, sha256, archive, folder, *wanted = sys.argv[1:]
    if not os.path.exists(archive):
        try:
            download(address, archive)
        except OSError as error:
            sys.exit(f"{address}: {error}")
    check(archive, sha256)
    unpack(archive, folder, wanted)


main()
