# Blender with the extension, without a window.   docker build -f containers/blender.Dockerfile -t pe-blender .
# docker run --rm -v "$PWD:/work" -u "$(id -u)" pe-blender car.blend --command pe optimize -o results
FROM debian:trixie-slim
RUN apt-get update \
    && apt-get install -y --no-install-recommends blender python3-numpy python3-venv \
        python3-requests python3-zstandard python3-cattr libegl1 libgl1 libgl1-mesa-dri \
    && rm -rf /var/lib/apt/lists/*
ENV BLENDER_USER_RESOURCES=/opt/blender
COPY . /src
RUN python3 -m venv /src/.venv \
    && /src/.venv/bin/pip install --no-cache-dir /src \
    && cd /src && .venv/bin/python tools/build_extension.py \
    && blender --command extension install-file -r user_default --enable dist/*.zip \
    && chmod -R a+rwX /opt/blender && rm -rf /src
WORKDIR /work
ENTRYPOINT ["blender", "-b"]
