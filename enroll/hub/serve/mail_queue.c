#include "enroll/hub/serve/mail_queue.h"

#include <sodium.h>
#include <stdlib.h>
#include <string.h>

bool hub_mail_topic(const char *topic, struct iso_fleet_id *door, bool *is_presence)
{
    static const char begin[] = "isotherm/door/";
    char id[ISO_FLEET_ID_TEXT_SIZE];

    if (strncmp(topic, begin, sizeof begin - 1) != 0 ||
        strnlen(topic, sizeof begin + sizeof id) < sizeof begin + sizeof id - 1) {
        return false;
    }
    memcpy(id, topic + sizeof begin - 1, sizeof id - 1);
    id[sizeof id - 1] = '\0';
    const char *rest = topic + sizeof begin - 1 + sizeof id - 1;
    const bool is_online = strcmp(rest, "/online") == 0;
    if ((!is_online && strcmp(rest, "/out") != 0) || iso_fleet_id_read(id, door)) {
        return false;
    }
    *is_presence = is_online;
    return true;
}

bool hub_mail_put(struct hub_mail_queue *queue, const struct iso_fleet_id *door, bool is_presence,
                  const void *bytes, size_t size)
{
    struct hub_mail *mail = NULL;

    if (size <= HUB_MAIL_BYTES_MAX && queue->bytes <= HUB_MAIL_BYTES_MAX - size) {
        mail = malloc(sizeof *mail + size);
    }
    if (!mail) {
        queue->dropped++;
        return false;
    }
    mail->next = NULL;
    mail->door = *door;
    mail->is_presence = is_presence;
    mail->size = size;
    memcpy(mail->bytes, bytes, size);
    *(queue->first ? queue->end : &queue->first) = mail;
    queue->end = &mail->next;
    queue->n++;
    queue->bytes += size;
    return true;
}

void hub_mail_drop_first(struct hub_mail_queue *queue)
{
    struct hub_mail *mail = queue->first;

    if (!mail) {
        return;
    }
    queue->first = mail->next;
    queue->n--;
    queue->bytes -= mail->size;
    sodium_memzero(mail->bytes, mail->size);
    free(mail);
}

void hub_mail_clear(struct hub_mail_queue *queue)
{
    while (queue->first) {
        hub_mail_drop_first(queue);
    }
}
