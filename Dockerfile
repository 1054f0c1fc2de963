# One image for every process of a mission; compose.yaml says which program a service runs, and where.
# BASE: the official slim Python, or a local image where no registry is reached (docker/local_base.py).
# USER_ID: the user of every process. PROCESSES: who gets a volume for its certificate.
ARG BASE=python:3.11-slim
FROM ${BASE}
COPY pyproject.toml constraints.txt docker/dependencies.py /build/
RUN python /build/dependencies.py /build/pyproject.toml > /build/requirements.txt \
 && python -m pip install --no-cache-dir --disable-pip-version-check --root-user-action ignore \
    --constraint /build/constraints.txt --requirement /build/requirements.txt
COPY . /onehop/
WORKDIR /onehop
ENV NUMBA_CACHE_DIR=/var/cache/onehop MPLCONFIGDIR=/tmp/matplotlib HOME=/tmp
ARG USER_ID=1000
ARG PROCESSES=""
RUN python docker/prepare.py
USER ${USER_ID}:${USER_ID}
ENV PYTHONDONTWRITEBYTECODE=1
