# syntax=docker/dockerfile:1@sha256:87999aa3d42bdc6bea60565083ee17e86d1f3339802f543c0d03998580f9cb89
# The page is built with Node and packed into the wheel; the last stage installs that wheel beside the locked
# packages, and holds neither npm nor a compiler nor the sources. Node itself is in it: it grows trees.
# One image serves as server, scheduler and worker.

FROM node:24-bookworm-slim@sha256:6f7b03f7c2c8e2e784dcf9295400527b9b1270fd37b7e9a7285cf83b6951452d AS page
WORKDIR /app
COPY package.json package-lock.json tsconfig.json ./
COPY web/package.json web/package.json
COPY web/player/package.json web/player/package.json
COPY tools/species/package.json tools/species/package.json
RUN npm ci --no-audit --no-fund
COPY web web
COPY docs/images/storm.webp docs/images/storm.webp
WORKDIR /app/web
RUN npm run build && npm run build:player
COPY tools/species /app/tools/species
RUN npm run build --prefix /app/tools/species

FROM python:3.11-slim-bookworm@sha256:a36c24f9cbdf4fd0f52d67f0823eeac19c2028c637cecc392d97f980d4fec56b AS wheel
ENV PIP_NO_CACHE_DIR=1 PIP_DISABLE_PIP_VERSION_CHECK=1
WORKDIR /app
COPY requirements/build.txt requirements/build.txt
RUN pip install --require-hashes --no-deps -r requirements/build.txt
COPY pyproject.toml setup.py README.md LICENSE NOTICE ./
COPY assets assets
COPY precompute precompute
COPY server server
COPY --from=page /app/web/dist web/dist
COPY --from=page /app/tools/species/dist tools/species/dist
COPY --from=page /app/web/player/dist/notebook web/player/dist/notebook
RUN pip wheel --no-deps --no-build-isolation --wheel-dir /wheel .

FROM python:3.11-slim-bookworm@sha256:a36c24f9cbdf4fd0f52d67f0823eeac19c2028c637cecc392d97f980d4fec56b
ENV PIP_NO_CACHE_DIR=1 PIP_DISABLE_PIP_VERSION_CHECK=1
# libraries that VTK (used by pytetwild through pyvista), OpenMP and Node need
# hadolint ignore=DL3008
RUN apt-get update \
    && apt-get install --yes --no-install-recommends \
        libgl1 libgomp1 libxrender1 libxext6 libx11-6 libatomic1 libstdc++6 \
    && rm -rf /var/lib/apt/lists/* \
    && useradd --no-create-home --uid 10001 galewood \
    && install --directory --owner=galewood /data
COPY --from=page /usr/local/bin/node /usr/local/bin/node
RUN node --version
WORKDIR /opt/galewood
RUN python -m venv /opt/galewood
ENV PATH=/opt/galewood/bin:$PATH
# the packages change less often than the wheel, so they are a layer of their own
RUN --mount=type=bind,source=requirements/base.txt,target=/base.txt \
    pip install --require-hashes --no-deps -r /base.txt
RUN --mount=type=bind,from=wheel,source=/wheel,target=/wheel \
    pip install --no-index --no-deps /wheel/*.whl && pip check
USER 10001
ENV GALEWOOD_DATA_DIR=/data \
    HOST=0.0.0.0 \
    PORT=8000 \
    NUMBA_CACHE_DIR=/data/cache/numba \
    HOME=/tmp \
    PYTHONDONTWRITEBYTECODE=1 \
    PYTHONUNBUFFERED=1
VOLUME /data
EXPOSE 8000
STOPSIGNAL SIGTERM
HEALTHCHECK --interval=10s --timeout=5s --start-period=60s --retries=3 \
    CMD ["python", "-c", "import urllib.request as u; u.urlopen('http://127.0.0.1:8000/api/health', timeout=4)"]
CMD ["galewood", "serve"]
