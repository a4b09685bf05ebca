# The program in a small image:
#   docker build -t vtex .
#   docker run --rm -v "$PWD:/work" vtex texture photo.jpg

# `rust-version` in Cargo.toml.
FROM rust:1.94-slim-bookworm AS rust
WORKDIR /vtex

FROM rust AS licences
RUN cargo install --locked cargo-about@0.9.1 --features cli
COPY . .
RUN cargo about generate --locked --fail --config packaging/about.toml \
    --output-file dependencies.html packaging/dependencies.hbs

FROM rust AS program
COPY . .
RUN CARGO_PROFILE_RELEASE_STRIP=symbols cargo build --locked --release

FROM debian:bookworm-slim
COPY --from=program /vtex/target/release/vtex /usr/local/bin/
COPY --from=licences /vtex/dependencies.html /usr/share/doc/vtex/
COPY LICENSE-MIT LICENSE-APACHE /usr/share/doc/vtex/
# The first user of most Linux systems, who can then write to the folder. Others: docker run --user "$(id -u):$(id -g)".
USER 1000:1000
WORKDIR /work
ENTRYPOINT ["vtex"]
CMD ["--help"]
