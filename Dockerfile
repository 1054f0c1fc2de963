# One image for every process of a mission; compose.yaml says which program a service runs, and where.
# BASE: the official slim Python, or a local image where no registry is reached (docker/local_base.py).
ARG BASE=python:3.11-slim
FROM ${BASE}
COPY pyproject.toml constraints.txt docker/dependencies.py /build/
RUN python /build/dependencies.py /build/pyproject.toml > /build/requirements.txt \
 && python -m pip install --no-cache-dir --disable-pip-version-check --root-user-action ignore \
    --constraint /build/constraints.txt --requirement /build/requirements.txt
COPY . /onehop/
