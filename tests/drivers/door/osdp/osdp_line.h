/* A serial line that is a pseudo-terminal, with the panel of the tests at one end. Time is real. */
#ifndef TESTS_DRIVERS_DOOR_OSDP_OSDP_LINE_H
#define TESTS_DRIVERS_DOOR_OSDP_OSDP_LINE_H

#include "tests/drivers/door/osdp/osdp_panel.h"

struct osdp_line {
    int master;    /* the panel's end */
    char path[64]; /* the device's end */
    uint32_t baud; /* the panel sends its bytes as fast as this line would carry them; 0: at once */
    struct panel panel;
};

/* Makes a line, and a panel for the address 5. */
void osdp_line_open(struct osdp_line *line, uint32_t baud);
void osdp_line_close(struct osdp_line *line);

/* Writes bytes of the panel. */
void osdp_line_write(const struct osdp_line *line, const uint8_t *bytes, size_t n);

/* Reads the reply to the panel's last frame; its code is -1 if none comes within 200 ms. */
void osdp_line_read(struct osdp_line *line, struct panel_reply *reply);

/* Repeats the panel's last frame until there is a reply. */
void osdp_line_insist(struct osdp_line *line, struct panel_reply *reply);

/* Sends a command and waits for the reply. Returns its code. */
int osdp_line_ask(struct osdp_line *line, uint8_t command, const void *data, size_t n,
                  struct panel_reply *reply);

/* Opens the secure channel with a key; the default key is known by its bytes. */
bool osdp_line_secure(struct osdp_line *line, const uint8_t key[16]);

#endif
