# cube_sim and its tests in a container: the two commands of README.md on Debian's Python.
#
#   docker build -t cube_sim .
#   docker run --rm cube_sim                                                  # flies the helix: exit code 0
#   docker run --rm cube_sim pytest scenarios                                 # every scenario as a test
#   docker run --rm --user $(id -u):$(id -g) -v "$PWD:/work" -w /work cube_sim cube-sim run missions
#
# A user whom the image does not know, a read-only file system (--read-only --tmpfs /tmp) and a missing home are all one
# to it: what is compiled lies in CUBE_SIM_CACHE_DIR, made by the run below. On a processor of another make it is made
# again, into that folder where it can be written to.
FROM python:3.11-slim-bookworm

# OpenMP, which the solver that confirms every allocation is linked to.
RUN apt-get update && apt-get install -y --no-install-recommends libgomp1 && rm -rf /var/lib/apt/lists/*

WORKDIR /cube_sim
COPY . .
ENV PIP_NO_CACHE_DIR=1
RUN python3 -m venv .venv && .venv/bin/pip install -q -c constraints.txt -e '.[dev]'

ENV PATH=/cube_sim/.venv/bin:$PATH CUBE_SIM_CACHE_DIR=/var/cache/cube_sim PYTHONDONTWRITEBYTECODE=1
RUN cube-sim run scenarios/cube_helix.yaml --record mcap --out /tmp/first \
    && rm -r /tmp/first && chmod -R a+rX /var/cache/cube_sim

CMD ["cube-sim", "run", "scenarios/cube_helix.yaml", "--out", "/tmp/first"]
