/* The notation of a GPIO line in the configuration. */
#include <errno.h>
#include <string.h>

#include "drivers/door/gpio_line.h"
#include "drivers/file/text.h"

enum { TEXT_SIZE = 192, WORDS_MAX = 5, OFFSET_MAX = 65535 };

static int copy_name(const char *name, size_t length, char out[ISO_GPIO_NAME_SIZE])
{
    if (length == 0 || length >= ISO_GPIO_NAME_SIZE) {
        return -EINVAL;
    }
    memcpy(out, name, length);
    out[length] = '\0';
    return 0;
}

/* Reads CHIP:OFFSET if a number follows the last colon, and otherwise a name. */
static int parse_line(const char *word, struct iso_gpio_spec *spec)
{
    const char *colon = strrchr(word, ':');
    size_t offset;
    if (colon && iso_text_count(colon + 1, &offset) == 0) {
        spec->offset = (unsigned)offset;
        return offset > OFFSET_MAX ? -EINVAL : copy_name(word, (size_t)(colon - word), spec->chip);
    }
    return copy_name(word, strlen(word), spec->name);
}

static int parse_word(const char *word, struct iso_gpio_spec *spec)
{
    static const struct {
        const char *word;
        enum iso_gpio_bias bias;
        enum iso_gpio_drive drive;
    } words[] = {
        {"pull-up", ISO_GPIO_PULL_UP, ISO_GPIO_PUSH_PULL},
        {"pull-down", ISO_GPIO_PULL_DOWN, ISO_GPIO_PUSH_PULL},
        {"no-pull", ISO_GPIO_BIAS_NONE, ISO_GPIO_PUSH_PULL},
        {"open-drain", ISO_GPIO_BIAS_AS_IS, ISO_GPIO_OPEN_DRAIN},
        {"open-source", ISO_GPIO_BIAS_AS_IS, ISO_GPIO_OPEN_SOURCE},
    };
    if (strcmp(word, "active-low") == 0 && !spec->active_low) {
        spec->active_low = true;
        return 0;
    }
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        if (strcmp(words[i].word, word) == 0) {
            if ((words[i].bias && spec->bias) || (words[i].drive && spec->drive)) {
                return -EINVAL;
            }
            spec->bias = words[i].bias ? words[i].bias : spec->bias;
            spec->drive = words[i].drive ? words[i].drive : spec->drive;
            return 0;
        }
    }
    return -EINVAL;
}

int iso_gpio_spec_parse(const char *owner, const char *text, struct iso_gpio_spec *out,
                        struct iso_fault *fault)
{
    struct iso_gpio_spec spec = {.chip = ""};
    const char *begin = owner ? owner : "", *colon = owner ? ": " : "";
    char copy[TEXT_SIZE];
    char *words[WORDS_MAX];
    if (strlen(text) >= sizeof copy) {
        return iso_fault_set_code(fault, ISO_FAULT_OPTION_WRONG, -EINVAL, "%s%stoo long for a line",
                                  begin, colon);
    }
    (void)strcpy(copy, text);
    const size_t n = iso_text_split(copy, ' ', words, WORDS_MAX);
    if (n > WORDS_MAX || parse_line(words[0], &spec)) {
        return iso_fault_set_code(fault, ISO_FAULT_OPTION_WRONG, -EINVAL,
                                  "%s%s'%s' is not a line (CHIP:OFFSET or NAME)", begin, colon,
                                  text);
    }
    for (size_t i = 1; i < n; i++) {
        if (parse_word(words[i], &spec)) {
            return iso_fault_set_code(
                fault, ISO_FAULT_OPTION_WRONG, -EINVAL,
                "%s%s'%s' in '%s' is unknown, or one word too many (active-low; "
                "pull-up, pull-down or no-pull; open-drain or open-source)",
                begin, colon, words[i], text);
        }
    }
    *out = spec;
    return 0;
}

enum iso_fault_code iso_gpio_fault_code(int error)
{
    switch (error) {
    case -EACCES:
        return ISO_FAULT_LINE_DENIED;
    case -EBUSY:
        return ISO_FAULT_LINE_BUSY;
    case -ENODEV:
        return ISO_FAULT_CHIP_GONE;
    case -ENOMEM:
        return ISO_FAULT_OUT_OF_MEMORY;
    default:
        return ISO_FAULT_LINE_FAILED;
    }
}
