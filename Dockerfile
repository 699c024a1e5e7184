# syntax=docker/dockerfile:1
# The page is built with Node, the service runs on Python; one image serves as server, scheduler and worker.

FROM node:20-bookworm-slim AS page
WORKDIR /app/web
COPY web/package.json web/package-lock.json ./
RUN npm ci --no-audit --no-fund
COPY web ./
RUN npm run build

FROM python:3.11-slim-bookworm
# libraries that VTK (used by pytetwild through pyvista) and OpenMP need
RUN apt-get update \
    && apt-get install --yes --no-install-recommends libgl1 libgomp1 libxrender1 libxext6 libx11-6 \
    && rm -rf /var/lib/apt/lists/* \
    && useradd --create-home --uid 10001 galewood \
    && install --directory --owner=galewood /data
WORKDIR /app
COPY requirements/base.txt requirements/base.txt
RUN pip install --no-cache-dir --require-hashes --no-deps -r requirements/base.txt
COPY pyproject.toml README.md ./
COPY precompute precompute
COPY server server
RUN pip install --no-cache-dir --no-deps --no-build-isolation --editable .
COPY assets assets
COPY --from=page /app/web/dist web/dist
USER galewood
ENV GALEWOOD_DATA_DIR=/data \
    HOST=0.0.0.0 \
    PORT=8000 \
    NUMBA_CACHE_DIR=/data/cache/numba \
    PYTHONUNBUFFERED=1
VOLUME /data
EXPOSE 8000
HEALTHCHECK --interval=10s --timeout=5s --start-period=30s --retries=3 \
    CMD ["python", "-c", "import urllib.request as u; u.urlopen('http://127.0.0.1:8000/healthz', timeout=4)"]
CMD ["galewood", "serve"]
