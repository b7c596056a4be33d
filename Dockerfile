# docker build -t drone-simulator .
# docker run --rm -it drone-simulator                                  flies the island
# docker run --rm -v "$PWD/out:/simulator/out" drone-simulator make fly ARGS="--no-teleop --duration 20 --film out/run1.mp4"
FROM debian:13-slim AS system

# The packages that requirements/system.sh checks for, and git for the tests. The development container ends here.
RUN apt-get update \
    && DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends \
       ca-certificates git make gcc g++ python3 python3-dev python3-venv \
       libegl1 libgl1 libegl-mesa0 libgl1-mesa-dri \
    && rm -rf /var/lib/apt/lists/*

FROM system
WORKDIR /simulator

# A separate layer, since the environment changes less often than the sources.
COPY Makefile ./
COPY requirements requirements
RUN make .venv/pins

COPY . .
RUN make build

ENV PATH=/simulator/.venv/bin:$PATH
CMD ["make", "fly"]
