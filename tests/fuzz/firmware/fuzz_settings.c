/* The bytes of the file of changed settings, as if they had been unsealed. */
#include <stdlib.h>
#include <string.h>

#include "firmware/settings/settings_file.h"
#include "tests/fuzz/fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static struct iso_settings_file file;
    static uint8_t again[ISO_SETTINGS_PLAIN_MAX];
    uint8_t *plain = fuzz_copy(data, size);
    file.number = 77;
    file.n = 55;
    if (iso_settings_get(plain, size, &file) == 0) {
        fuzz_check(file.n <= ISO_LIVE_KEYS_MAX, "a file has a limit");
        fuzz_check(iso_settings_put(&file, again) == size && memcmp(again, plain, size) == 0,
                   "a file that was read is written again with the same bytes");
        struct iso_config config = iso_config_default();
        for (size_t i = 0; i < file.n; i++) {
            const struct iso_stored_setting *item = &file.items[i];
            const struct iso_config_key *key = iso_live_key_find(item->section, item->key);
            char value[ISO_LIVE_VALUE_SIZE];
            if (key && iso_live_key_set(&config, key, item->value, NULL) == 0) {
                iso_live_key_print(&config, key, value);
                fuzz_check(iso_live_key_set(&config, key, value, NULL) == 0,
                           "a value in force can be set");
            }
        }
    } else {
        fuzz_check(file.number == 77 && file.n == 55, "the output is unchanged after an error");
    }
    free(plain);
    return 0;
}
