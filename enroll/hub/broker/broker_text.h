/* The texts of the files that configure mosquitto. Pure. */
#ifndef HUB_BROKER_BROKER_TEXT_H
#define HUB_BROKER_BROKER_TEXT_H

#include <stdint.h>
#include <stdio.h>

#include "enroll/hub/store/hub_door.h"

struct broker_places {
    const char *folder;      /* where mosquitto finds the files, without a slash at the end */
    const char *persistence; /* mosquitto's own folder */
    const char *hub_address; /* to which the hub's listener is bound */
    uint16_t port, hub_port; /* for the doors; for the hub, 0: it uses the doors' listener */
    bool home_assistant;     /* a certificate for Home Assistant is made, too */
};

/* Writes mosquitto.conf. */
void broker_text_config(FILE *out, const struct broker_places *places);

/* Writes the beginning of the list of rights: what the hub and Home Assistant may do, and that each
 * door reads what is addressed to it and writes in its own name. Mosquitto refuses everything
 * else. */
void broker_text_hub(FILE *out);

/* Writes the rights of one door: it reads the streams of its zones. A door that has not joined, or
 * is expelled, may do nothing, also by a connection that it has. */
void broker_text_door(FILE *out, const struct hub_door *door);

#endif
