// Unity (URP, Shader Graph): Custom Function node that plays @NAME@, a tree whose looping sway is in vertex
// animation textures. Written by Galewood. How to connect it: see the page "Export to engines", section Unity.
//
// Assumes an importer that mirrors x (glTFast: x -> -x, v -> 1 - v) and textures imported with sRGB off, no
// compression, no mipmaps, Filter Point, Non-Power of Two None.
#ifndef GALEWOOD_VAT_INCLUDED
#define GALEWOOD_VAT_INCLUDED

float3 GalewoodTurned(float4 q, float3 v)
{
    return v + 2.0 * cross(q.xyz, cross(q.xyz, v) + q.w * v);
}

// Mirrored at x = 0: vectors change the sign of x, rotation vectors those of y and z.
void GalewoodVat_float(
    float3 Position, float3 Normal, float3 Tangent, float2 UV1, float Time, float Start,
    UnityTexture2D OffsetMap, UnityTexture2D RotationMap, UnityTexture2D PivotMap,
    out float3 OutPosition, out float3 OutNormal, out float3 OutTangent)
{
    const int frames = @FRAMES@;
    const int rows = @ROWS@;
    const float fps = @FPS@;
    const float3 offsetLow = float3(@OFFSET_LOW@), offsetHigh = float3(@OFFSET_HIGH@);
    const float3 rotationLow = float3(@ROTATION_LOW@), rotationHigh = float3(@ROTATION_HIGH@);
    const float3 pivotLow = float3(@PIVOT_LOW@), pivotHigh = float3(@PIVOT_HIGH@);

    uint width, height, pivotWidth, pivotHeight;
    OffsetMap.tex.GetDimensions(width, height);
    PivotMap.tex.GetDimensions(pivotWidth, pivotHeight);
    // v counts from the bottom, as do the rows of Unity's textures: frame f lies f * rows below frame 0
    int column = int(floor(UV1.x * float(width)));
    int fromTop = int(floor((1.0 - UV1.y) * float(height)));
    float at = frac(Time * fps / float(frames) + Start) * float(frames);
    int first = min(int(at), frames - 1);
    int second = (first + 1) % frames;
    float share = at - float(first);
    int3 a = int3(column, int(height) - 1 - (fromTop + first * rows), 0);
    int3 b = int3(column, int(height) - 1 - (fromTop + second * rows), 0);
    int3 c = int3(column, int(pivotHeight) - 1 - fromTop, 0);

    float3 moved = lerp(OffsetMap.tex.Load(a).rgb, OffsetMap.tex.Load(b).rgb, share);
    float3 turn = lerp(RotationMap.tex.Load(a).rgb, RotationMap.tex.Load(b).rgb, share);
    float3 pivot = lerp(pivotLow, pivotHigh, PivotMap.tex.Load(c).rgb);
    moved = lerp(offsetLow, offsetHigh, moved);
    turn = lerp(rotationLow, rotationHigh, turn);
    float w = sqrt(max(1.0 - dot(turn, turn), 0.0));
    moved.x = -moved.x;
    pivot.x = -pivot.x;
    float4 q = float4(turn.x, -turn.y, -turn.z, w);

    OutPosition = pivot + moved + GalewoodTurned(q, Position - pivot);
    OutNormal = GalewoodTurned(q, Normal);
    OutTangent = GalewoodTurned(q, Tangent);
}

#endif
