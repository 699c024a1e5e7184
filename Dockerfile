# syntax=docker/dockerfile:1
# The page is built with Node, the packages with pip; the last stage holds neither npm nor a compiler.
# One image serves as server, scheduler and worker.

FROM node:20-bookworm-slim AS page
WORKDIR /app/web
COPY web/package.json web/package-lock.json ./
RUN npm ci --no-audit --no-fund
COPY web ./
RUN npm run build

FROM python:3.11-slim-bookworm AS packages
ENV PIP_NO_CACHE_DIR=1 PIP_DISABLE_PIP_VERSION_CHECK=1
RUN python -m venv /opt/galewood
ENV PATH=/opt/galewood/bin:$PATH
WORKDIR /app
COPY requirements/base.txt requirements/base.txt
RUN pip install --require-hashes --no-deps -r requirements/base.txt
COPY pyproject.toml README.md ./
COPY precompute precompute
COPY server server
RUN pip install --no-deps --no-build-isolation --editable .

FROM python:3.11-slim-bookworm
# libraries that VTK (used by pytetwild through pyvista) and OpenMP need
# hadolint ignore=DL3008
RUN apt-get update \
    && apt-get install --yes --no-install-recommends libgl1 libgomp1 libxrender1 libxext6 libx11-6 \
    && rm -rf /var/lib/apt/lists/* \
    && useradd --no-create-home --uid 10001 galewood \
    && install --directory --owner=galewood /data
WORKDIR /app
COPY --from=packages /opt/galewood /opt/galewood
COPY --from=packages /app /app
COPY assets assets
COPY --from=page /app/web/dist web/dist
USER 10001
ENV PATH=/opt/galewood/bin:$PATH \
    GALEWOOD_DATA_DIR=/data \
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
