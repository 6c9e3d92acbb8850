#!/usr/bin/env bash
# Snakemake 9.27.1: an input that is taken away while a run goes on takes its folder along, and the folders above it.
#
# At the end of a run the folders of all outputs and inputs that are missing are removed where they are empty, and so is
# every folder above them that becomes empty by that. Documented is that folders of temporary and of failed outputs are
# cleaned up. Here three folders are the user's own: scans/monday/left holds one file that a rule reads. It is moved
# elsewhere while the rule runs. The rule succeeds, and so does the run; afterwards scans is gone, so that what wants to
# put the next file there (a scanner, a synchronised folder) finds no place.
# Seen with Python 3.11 on Linux.
#
# Exits 0 while this is so, 1 once it behaves otherwise.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check snakemake==9.27.1
mkdir -p "$folder/lab/scans/monday/left"
cd "$folder/lab"
echo solid > scans/monday/left/part.stl
cat > Snakefile <<'RULES'
rule measure:
    input:
        "scans/monday/left/part.stl",
    output:
        "size.txt",
    shell:
        "wc -c < {input} > {output}; mv {input} .."
RULES
"$folder/venv/bin/snakemake" --cores 1 --quiet all > /dev/null
echo "size.txt: $(cat size.txt); scans is $([ -d scans ] && echo there || echo gone)"
[ -s size.txt ] && [ ! -d scans ]
