/* Lines of the audit log: headers and sealed records. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/audit/audit_line.h"
#include "tests/fuzz/fuzz.h"

static void try_header(const char *line)
{
    struct iso_audit_header header;
    char again[ISO_AUDIT_LINE_MAX];
    if (iso_audit_header_get(line, &header) == 0) {
        const size_t length = iso_audit_header_put(&header, again);
        fuzz_check(length == strlen(line) + 1 && memcmp(again, line, length - 1) == 0,
                   "a header that was read is written again with the same bytes");
    }
}

/* A sealed record can be opened, and it cannot be opened after one of its bits has changed. */
static void try_record(const struct iso_audit_seal *seal, const char *text, size_t size)
{
    static char line[ISO_AUDIT_LINE_MAX];
    static struct iso_audit_opened opened;
    struct iso_audit_link link = {{1}};
    const struct iso_heads known = {.count = {size, 0, 3, 4}};
    const size_t length = iso_audit_line_close(seal, 7, &known, text, size, line, &link);
    fuzz_check(iso_audit_line_open(seal, 7, line, length - 1, &opened) == 0,
               "a sealed record can be opened");
    fuzz_check(opened.size == size && memcmp(opened.text, text, size) == 0,
               "the text is unchanged");
    fuzz_check(memcmp(&opened.behind, &link, sizeof link) == 0, "the same link");
    fuzz_check(memcmp(&opened.known, &known, sizeof known) == 0, "the known heads are unchanged");
    line[2 + size % (length - 3)] ^= 1;
    fuzz_check(iso_audit_line_open(seal, 7, line, length - 1, &opened) != 0,
               "a changed record is refused");
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static const struct iso_seal_key key = {{3}};
    static struct iso_audit_opened opened;
    struct iso_fault fault = {.text = ""};
    fuzz_check(iso_seal_start(&fault) == 0, fault.text);
    const struct iso_audit_seal seal = iso_audit_seal_of(1, &key);
    char *line = (char *)fuzz_copy(data, size);
    try_header(line);
    fuzz_check(iso_audit_line_open(&seal, 1, line, size, &opened) != 0,
               "a forged record is refused");
    try_record(&seal, line, size < ISO_AUDIT_TEXT_MAX ? size : ISO_AUDIT_TEXT_MAX);
    free(line);
    return 0;
}
