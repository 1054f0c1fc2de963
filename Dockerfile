# One image for every process of a mission; compose.yaml says which program a service runs.
# BASE: the official slim Python, or a local image where no registry is reached (docker/local_base.py).
ARG BASE=python:3.11-slim
FROM ${BASE}

WORKDIR /onehop
COPY pyproject.toml constraints.txt docker/dependencies.py ./
RUN python dependencies.py pyproject.toml > requirements.txt \
 && python -m pip install --no-cache-dir --disable-pip-version-check \
    --constraint constraints.txt --requirement requirements.txt

COPY onehop onehop
COPY robot_agent robot_agent
COPY world_server world_server
COPY radio_proxy radio_proxy
COPY scenarios scenarios

ENV PYTHONUNBUFFERED=1 OPENBLAS_NUM_THREADS=1 NUMBA_CACHE_DIR=/tmp/numba
CMD ["python", "-c", "print('start a service of compose.yaml')"]
