# Puts the programs of the browser tests beside their packages, so that Node.js finds these and the tree of the project stays as it is.
# Sourced by run.sh and hub/run.sh; `here` is this folder, `build` the build. Sets `web`, the folder with all of it.
for command in node npm "${CHROMIUM:-chromium}"; do
    command -v "$command" >/dev/null || {
        echo "$0: there is no command $command: cmake/install_packages.sh web" >&2
        exit 2
    }
done
web=$build/web
mkdir -p "$web/hub"
rm -f "$web"/*.mjs "$web"/hub/*.mjs
cp "$here"/*.mjs "$web"
cp "$here"/hub/*.mjs "$web/hub"
if ! cmp -s "$here/package-lock.json" "$web/installed.json"; then
    rm -f "$web/installed.json"
    cp "$here/package.json" "$here/package-lock.json" "$web"
    (cd "$web" && npm ci --ignore-scripts --no-audit --no-fund --cache "$web/cache")
    cp "$here/package-lock.json" "$web/installed.json"
fi
