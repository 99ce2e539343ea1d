/* What the web server tells other programs of this machine: the fingerprint of its certificate, for
 * the screen at the door. */
#ifndef WEB_PUBLISHED_H
#define WEB_PUBLISHED_H

/* Writes the fingerprint to the file "fingerprint" of the folder that systemd has made for the
 * service (RuntimeDirectory=), readable for everybody. Without such a folder it does nothing. If
 * the file cannot be written, it prints a line: the pages work without it. */
void web_published_write(const char *fingerprint);

#endif
