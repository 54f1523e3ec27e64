# The command pe.   docker build -f containers/pe.Dockerfile -t pe .
# In the folder of a study:   docker run --rm -v "$PWD:/work" -u "$(id -u)" pe score study.toml
FROM debian:trixie-slim
RUN apt-get update \
    && apt-get install -y --no-install-recommends python3-venv \
    && rm -rf /var/lib/apt/lists/*
COPY . /src
RUN python3 -m venv /opt/pe \
    && /opt/pe/bin/pip install --no-cache-dir "/src[meshes]" \
    && rm -rf /src/build
ENV PATH=/opt/pe/bin:$PATH
WORKDIR /work
ENTRYPOINT ["pe"]
