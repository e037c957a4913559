# SPDX-License-Identifier: Apache-2.0
# docker build -t tauext . && docker run --rm tauext tauext-bench --benchmark_filter=wallmobot3/step/
FROM debian:12@sha256:9344f8b8992482f80cba753f323adeaf17690076c095ccff6cc9536be98185dc AS build
COPY . /tauext
WORKDIR /tauext
RUN ci/package

FROM debian:12@sha256:9344f8b8992482f80cba753f323adeaf17690076c095ccff6cc9536be98185dc
RUN --mount=type=bind,from=build,source=/tauext/build/release/package,target=/packages \
    apt-get update \
 && apt-get install -y --no-install-recommends /packages/tauext_*.deb /packages/python3-tauext_*.deb \
 && rm -rf /var/lib/apt/lists/*
USER nobody
WORKDIR /tmp
CMD ["tauext-bench", "--help"]
