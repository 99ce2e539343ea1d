#!/bin/sh
# Prints the list of the parts of an image in the format SPDX 2.3 (JSON), from the list of packages that root.sh has made: one line a
# package with name, version, architecture, source and version of the source.
#
#   sbom.sh PACKAGES NAME VERSION      PACKAGES: the file usr/lib/isotherm-image/packages of the root; NAME, VERSION: of the image
#
# The licence of each package is in the image, /usr/share/doc/NAME/copyright; Debian's files of this kind are not in the words of SPDX, so
# the list says NOASSERTION. SOURCE_DATE_EPOCH is the time of the document.
set -eu
packages=$1 name=$2 version=$3
created=$(date -u -d "@$SOURCE_DATE_EPOCH" +%Y-%m-%dT%H:%M:%SZ)
sum=$(sha256sum "$packages" | cut -c 1-32)
awk -F '\t' -v name="$name" -v version="$version" -v created="$created" -v sum="$sum" '
    function part(id, name, version, more) {
        return sprintf("  {\"SPDXID\": \"SPDXRef-%s\", \"name\": \"%s\", \"versionInfo\": \"%s\", \"downloadLocation\": \"NOASSERTION\", " \
            "\"filesAnalyzed\": false, \"licenseConcluded\": \"NOASSERTION\", \"licenseDeclared\": \"NOASSERTION\", " \
            "\"copyrightText\": \"NOASSERTION\"%s}", id, name, version, more)
    }
    function escaped(text) {
        gsub(/\+/, "%2B", text)
        gsub(/:/, "%3A", text)
        return text
    }
    # The characters that an identifier may have.
    function identifier(text) {
        gsub(/[^A-Za-z0-9.-]/, "-", text)
        return text
    }
    BEGIN {
        printf "{\"spdxVersion\": \"SPDX-2.3\", \"dataLicense\": \"CC0-1.0\", \"SPDXID\": \"SPDXRef-DOCUMENT\", \"name\": \"%s-%s\",\n", name, version
        printf " \"documentNamespace\": \"https://isotherm.example/spdx/%s-%s-%s\",\n", name, escaped(version), sum
        printf " \"creationInfo\": {\"created\": \"%s\", \"creators\": [\"Tool: isotherm-image\"]},\n \"packages\": [\n", created
        printf "%s", part("Image", name, version, ", \"primaryPackagePurpose\": \"OPERATING-SYSTEM\"")
        relations = "  {\"spdxElementId\": \"SPDXRef-DOCUMENT\", \"relationshipType\": \"DESCRIBES\", \"relatedSpdxElement\": \"SPDXRef-Image\"}"
    }
    {
        id = "Package-" identifier($1) "-" NR
        more = sprintf(", \"sourceInfo\": \"built from %s %s\", \"externalRefs\": [{\"referenceCategory\": \"PACKAGE-MANAGER\", " \
            "\"referenceType\": \"purl\", \"referenceLocator\": \"pkg:deb/%s/%s@%s?arch=%s\"}]", $4, $5, $4 == "isotherm" ? "isotherm" : "debian", $1, escaped($2), $3)
        printf ",\n%s", part(id, $1, $2, more)
        relations = relations sprintf(",\n  {\"spdxElementId\": \"SPDXRef-Image\", \"relationshipType\": \"CONTAINS\", \"relatedSpdxElement\": \"SPDXRef-%s\"}", id)
    }
    END {
        printf "\n ],\n \"relationships\": [\n%s\n ]}\n", relations
    }' "$packages"
