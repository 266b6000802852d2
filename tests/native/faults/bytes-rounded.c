/* A serialized state carries its numbers in single precision.
 * replaces: real
 * detected by: serialized-state-to-the-bit in default
 */
struct stream;

void true_real(struct stream *stream, double *value);
void real(struct stream *stream, double *value);

void real(struct stream *stream, double *value)
{
    double rounded = (float)*value;
    true_real(stream, &rounded);
    *value = rounded;
}
