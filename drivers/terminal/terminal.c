#include "drivers/terminal/terminal.h"

#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

enum { USUAL_COLUMNS = 80 };

static bool is_set(const char *name)
{
    const char *value = getenv(name);

    return value && *value;
}

static bool knows_colours(void)
{
    const char *type = getenv("TERM");

    return type && *type && strcmp(type, "dumb") != 0 && !is_set("NO_COLOR");
}

struct iso_terminal iso_terminal_of(FILE *out)
{
    struct iso_terminal terminal = {.out = out, .columns = USUAL_COLUMNS};
    struct winsize size;

    terminal.is_terminal = isatty(fileno(out));
    terminal.colour = terminal.is_terminal && knows_colours();
    if (terminal.is_terminal && ioctl(fileno(out), TIOCGWINSZ, &size) == 0 && size.ws_col > 0) {
        terminal.columns = size.ws_col;
    }
    return terminal;
}

const char *iso_terminal_paint(const struct iso_terminal *terminal, enum iso_paint paint)
{
    static const char *const sequences[] = {
        [ISO_PAINT_PLAIN] = "\033[0m",    [ISO_PAINT_GOOD] = "\033[32m",
        [ISO_PAINT_WARNING] = "\033[33m", [ISO_PAINT_BAD] = "\033[31m",
        [ISO_PAINT_HEADING] = "\033[1m",
    };

    return terminal->colour ? sequences[paint] : "";
}
