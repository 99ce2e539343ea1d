#include "enroll/cli/image/os_release.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/cli/machine/text_file.h"

/* Copies the value of a line KEY=VALUE or KEY="VALUE". */
static void copy_value(const char *value, char *out, size_t size)
{
    const char quote = *value == '"' || *value == '\'' ? *value : '\n';
    const char ends[] = {quote, '\n', '\0'};

    value += quote != '\n';
    (void)snprintf(out, size, "%.*s", (int)strcspn(value, ends), value);
}

static void find_value(const char *text, const char *key, char *out, size_t size)
{
    const size_t length = strlen(key);

    out[0] = '\0';
    for (const char *line = text; *line; line += strspn(line, "\n")) {
        if (strncmp(line, key, length) == 0 && line[length] == '=') {
            copy_value(line + length + 1, out, size);
        }
        line += strcspn(line, "\n");
    }
}

void cli_os_release_value(const char *path, const char *key, char *out, size_t size)
{
    char *text = cli_text_file_read(path, NULL);

    find_value(text ? text : "", key, out, size);
    free(text);
}

void cli_os_release_read(const char *path, struct cli_os_release *out)
{
    cli_os_release_value(path, "PRETTY_NAME", out->name, sizeof out->name);
    cli_os_release_value(path, "IMAGE_ID", out->image, sizeof out->image);
    cli_os_release_value(path, "IMAGE_VERSION", out->version, sizeof out->version);
}
