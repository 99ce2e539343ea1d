/* A file as the body of a request. By XMLHttpRequest, because fetch does not say how much has been
 * sent. */

import {BASE, problem} from './ask.js';
import {Fault} from './fault.js';

/* Resolves when the server has taken the file. onSent(share) is called with a number from 0 to 1.
 * `signal` ends it: then an AbortError is thrown. */
export function upload(path, file, onSent, signal) {
    return new Promise((resolve, reject) => {
        const request = new XMLHttpRequest();
        const abort = () => request.abort();
        request.open('POST', BASE + path);
        request.setRequestHeader('Content-Type', 'application/octet-stream');
        request.upload.addEventListener(
            'progress', (event) => event.lengthComputable && onSent(event.loaded / event.total));
        request.addEventListener('load', async () => {
            if (request.status >= 200 && request.status < 300) {
                resolve();
                return;
            }
            const { status, statusText, responseText } = request;
            reject(await problem(new Response(responseText, { status, statusText }), path));
        });
        request.addEventListener('error', () => reject(new Fault('no-connection')));
        request.addEventListener('abort', () => reject(new DOMException('', 'AbortError')));
        request.addEventListener('loadend', () => signal?.removeEventListener('abort', abort));
        signal?.addEventListener('abort', abort);
        request.send(file);
    });
}
