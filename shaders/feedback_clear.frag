// Nothing has landed on any pixel yet.
#version 460
layout(location = 0) out uint nearest;
layout(location = 1) out uint owner;
void main() { nearest = owner = 0xFFFFFFFFu; }
