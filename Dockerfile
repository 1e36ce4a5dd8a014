# docker build -t palpate .
# docker run --rm --network host --cap-add SYS_NICE --ulimit rtprio=99 --ulimit memlock=-1 palpate serve builtin:teardrop
FROM rust:1.89-slim-bookworm AS build
RUN apt-get update && apt-get install -y --no-install-recommends gcc libc6-dev && rm -rf /var/lib/apt/lists/*
WORKDIR /src
COPY . .
RUN cargo build --locked --release -p palpate && strip target/release/palpate

FROM gcr.io/distroless/cc-debian12
COPY --from=build /src/target/release/palpate /usr/bin/palpate
WORKDIR /data
ENTRYPOINT ["/usr/bin/palpate"]
CMD ["--help"]
