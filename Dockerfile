# SPDX-License-Identifier: Apache-2.0
# docker build -t tauext . && docker run --rm tauext tauext-bench --benchmark_filter=wallmobot3/step/
# Without a hash: what Debian mends counts for more here than the same image twice.
FROM debian:13 AS build
COPY . /tauext
WORKDIR /tauext
RUN ci/package

FROM debian:13
RUN --mount=type=bind,from=build,source=/tauext/build/release/package,target=/packages \
    apt-get update \
 && apt-get install -y --no-install-recommends /packages/tauext_*.deb /packages/python3-tauext_*.deb \
 && rm -rf /var/lib/apt/lists/*
USER nobody
WORKDIR /tmp
CMD ["tauext-bench", "--help"]
