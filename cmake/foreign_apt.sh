# apt for another architecture than this machine's, for scripts: `. cmake/foreign_apt.sh`. Plain sh.

# foreign_apt ARCH FOLDER: from here on apt is about packages of the architecture ARCH (Debian's name, such as arm64). It gets a folder
# FOLDER/apt with lists of its own and without installed packages, so that this machine does not have to know the architecture. It ends
# the script with the last lines of apt's log if the lists cannot be fetched.
foreign_apt() {
    apt=$2/apt
    rm -rf "$apt"
    mkdir -p "$apt/lists/partial" "$apt/cache/archives/partial" "$apt/parts"
    : >"$apt/status"
    signed="[arch=$1 signed-by=/usr/share/keyrings/debian-archive-keyring.gpg]"
    cat >"$apt/sources.list" <<END
deb $signed ${ISOTHERM_MIRROR:-http://deb.debian.org/debian} bookworm main
deb $signed ${ISOTHERM_MIRROR:-http://deb.debian.org/debian} bookworm-updates main
deb $signed ${ISOTHERM_MIRROR_SECURITY:-http://deb.debian.org/debian-security} bookworm-security main
END
    cat >"$apt/apt.conf" <<END
APT::Architecture "$1";
APT::Architectures { "$1"; };
APT::Sandbox::User "$(id -un)";
Dir::State "$apt";
Dir::State::lists "$apt/lists";
Dir::State::status "$apt/status";
Dir::Cache "$apt/cache";
Dir::Etc::sourcelist "$apt/sources.list";
Dir::Etc::sourceparts "$apt/parts";
Dir::Etc::preferencesparts "$apt/parts";
END
    APT_CONFIG=$apt/apt.conf
    export APT_CONFIG
    apt-get update -q >"$apt/log" 2>&1 || {
        tail -n 5 "$apt/log" >&2
        exit 1
    }
}
