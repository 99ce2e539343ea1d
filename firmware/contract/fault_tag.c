#include "firmware/contract/fault_tag.h"

#include <stdio.h>

const char *iso_fault_word(enum iso_fault_code code)
{
    return code == ISO_FAULT_NONE ? "" : iso_fault_code_name(code);
}

const char *iso_fault_tag(enum iso_fault_code code, char tag[ISO_FAULT_TAG_SIZE])
{
    tag[0] = '\0';
    if (code != ISO_FAULT_NONE) {
        (void)snprintf(tag, ISO_FAULT_TAG_SIZE, " [%s]", iso_fault_code_name(code));
    }
    return tag;
}
